; BROKEN     Twin of 13c_integer_turn_guard_implies_exact.smt2: the factor 1000 between seconds
;            and milliseconds is forgotten.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; braking, mm/s^2
(declare-const E Real)        ; reaction time, ms
(declare-const V Real)        ; speed of the class, mm/s
(declare-const kappa Real)    ; closing cosine, exact
(declare-const K Real)        ; closing cosine in thousandths, rounded up
(declare-const s Real)        ; own way since seen, exact, mm
(declare-const S Real)        ; the same, rounded up
(declare-const age Real)      ; age, exact, s
(declare-const G Real)        ; the same in ms, rounded up
(declare-const d Real)        ; clearance, exact, mm
(declare-const D Real)        ; the same, rounded down
(declare-const w Real)        ; greatest speed until braking, mm/s
(declare-const way1 Real)     ; w E/1000, rounded up, mm
(declare-const way2 Real)     ; w^2/2b, rounded up, mm
(declare-const omega Real)    ; turn rate, mrad/s
(declare-const alpha Real)    ; turn acceleration, mrad/s^2
; Formulas
(define-fun eps () Real (/ E 1000))
(define-fun way_to_rest ((w Real)) Real (+ (* w eps) (/ (* w w) (* 2 b))))
(define-fun turn_need () Real (+ (* kappa (+ s (way_to_rest w))) (* V (+ age eps (/ omega alpha)))))
(define-fun left () Real (- (* 1000 D) (* K (+ S way1 way2)) (* V (+ G E))))

; Assumptions
(assert (and (> b 0) (> E 0)))
(assert (and (>= V 0) (>= s 0) (>= age 0) (>= w 0) (>= way1 0) (>= way2 0)))
(assert (<= 0 kappa 1))
(assert (>= K (* 1000 kappa)))
(assert (>= S s))
(assert (>= G (* 1000 age)))
(assert (<= D d))
(assert (>= (* 1000 way1) (* w E)))               ; 13a
(assert (>= (* 2 b way2) (* w w)))                 ; 13a
(assert (and (>= omega 0) (> alpha 0)))
(assert (<= (* V omega) (* alpha left)))                     ; BROKEN: no 1000

; Conclusion, negated
(assert (not (<= turn_need d)))
(check-sat)
