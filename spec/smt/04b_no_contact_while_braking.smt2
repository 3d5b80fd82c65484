; THEOREM    04b: the whole plan, second part: no contact while the robot brakes.
; ASSUMED    The guard holds; at te <= eps the robot begins to brake from ve <= w, steadily at
;            beta >= b, and still moves after the time t of braking.
; CONCLUDED  The clearance is 0 at least at that instant; as t is any, at every instant until
;            rest.
; SOURCE     Mitsch, Ghorbal, Vogelbacher, Platzer, IJRR 36(12), 2017, Theorem 2.
; TWIN       the guard takes the brakes for twice as strong.
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
(declare-const d Real)        ; clearance when the thing was seen
(declare-const w Real)        ; greatest speed until the robot begins to brake
(declare-const te Real)       ; when the command to rest takes effect
(declare-const xe Real)       ; way until then
(declare-const ve Real)       ; speed then
(declare-const beta Real)     ; actual braking
(declare-const t Real)        ; time that passes
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
(assert (>= te 0))
(assert (>= xe 0))
(assert (>= ve 0))
(assert (>= t 0))
(assert (<= (need w) d))
(assert (<= te eps))
(assert (<= xe (* w te)))
(assert (<= ve w))
(assert (>= beta b))
(assert (<= (* beta t) ve))

; Conclusion, negated
(assert (not (>= (- d (* kappa (+ s xe (- (* ve t) (/ (* beta t t) 2)))) (* V (+ age te t))) 0)))
(check-sat)
