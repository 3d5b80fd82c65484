; THEOREM    06: the clearance is measured with an error.
; ASSUMED    The clearance is measured as dm, off by Delta at most; the guard is given dm - Delta.
;            Then the robot reacts and brakes as in 03b.
; CONCLUDED  At each instant of braking the state is safe for the true clearance.
; SOURCE     Mitsch, Ghorbal, Vogelbacher, Platzer, IJRR 36(12), 2017, Theorem 6.
; TWIN       the guard is given what was measured.
; SOLVERS    z3
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const s Real)        ; robot's own way since the thing was seen
(declare-const age Real)      ; time since the thing was seen
(declare-const d Real)        ; true clearance
(declare-const dm Real)       ; measured clearance
(declare-const Delta Real)    ; greatest error
(declare-const w Real)        ; greatest speed until the robot begins to brake
(declare-const te Real)       ; when the command to rest takes effect
(declare-const xe Real)       ; way until then
(declare-const ve Real)       ; speed then
(declare-const tb Real)       ; time spent braking
(declare-const xb Real)       ; way while braking
(declare-const v2 Real)       ; speed after braking
; Formulas
(define-fun way_to_rest ((w Real)) Real (+ (* w eps) (/ (* w w) (* 2 b))))
(define-fun time_to_rest ((w Real)) Real (+ eps (/ w b)))
(define-fun need ((w Real)) Real
  (+ (* kappa (+ s (way_to_rest w))) (* V (+ age (time_to_rest w)))))
(define-fun safe_need ((v Real)) Real (+ (/ (* kappa v v) (* 2 b)) (/ (* V v) b)))

; Assumptions
(assert (> b 0))
(assert (> eps 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= s 0))
(assert (>= age 0))
(assert (>= Delta 0))
(assert (>= w 0))
(assert (>= te 0))
(assert (>= xe 0))
(assert (>= ve 0))
(assert (>= tb 0))
(assert (>= xb 0))
(assert (>= v2 0))
(assert (and (<= (- dm d) Delta) (<= (- d dm) Delta)))
(assert (<= (need w) (- dm Delta)))
(assert (<= te eps))
(assert (<= xe (* w te)))
(assert (<= ve w))
(assert (<= v2 ve))
(assert (<= (* b tb) (- ve v2)))                  ; braking at b or harder: 01b, 01c
(assert (<= (* 2 b xb) (- (* ve ve) (* v2 v2))))

; Conclusion, negated
(assert (not (<= (safe_need v2) (- d (* kappa (+ s xe xb)) (* V (+ age te tb))))))
(check-sat)
