; BROKEN     Twin of 12_iso_13855_form.smt2: T is the time to detect and react, without the time
;            to stop.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const s Real)        ; robot's own way since the thing was seen
(declare-const age Real)      ; time since the thing was seen
(declare-const w Real)        ; greatest speed until the robot begins to brake
(declare-const K Real)        ; approach speed
(declare-const T Real)        ; time to standstill
(declare-const C Real)        ; the machine's share
; Formulas
(define-fun way_to_rest ((w Real)) Real (+ (* w eps) (/ (* w w) (* 2 b))))
(define-fun time_to_rest ((w Real)) Real (+ eps (/ w b)))
(define-fun need ((w Real)) Real
  (+ (* kappa (+ s (way_to_rest w))) (* V (+ age (time_to_rest w)))))

; Assumptions
(assert (> b 0))
(assert (> eps 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= s 0))
(assert (>= age 0))
(assert (>= w 0))
(assert (= kappa 1))
(assert (= K V))
(assert (= T (+ age eps)))                                   ; BROKEN: w/b is missing
(assert (= C (+ s (* w eps) (/ (* w w) (* 2 b)))))

; Conclusion, negated
(assert (not (= (need w) (+ (* K T) C))))
(check-sat)
